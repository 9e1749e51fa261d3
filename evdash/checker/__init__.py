"""The independent checker: it shares no code with grid or scheduling, and holds their answers
against the scenario itself."""
