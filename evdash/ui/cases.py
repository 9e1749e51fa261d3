"""Cases prepared for the lecture. Their facts are held against the bundled days by a test."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Case:
    """A question, the bundled day it is asked on, what to press, what to see and why."""

    question: str
    preset: str
    about: str
    press: tuple[str, ...]
    see: str


CASES = (
    Case(
        "Chargers are free. Why is a vehicle refused?",
        "summer-weekday",
        "A summer weekday: 12 chargers at a feeder whose evening is nearly full without them.",
        (
            "Press **Step** until the clock shows 19:00, and watch **Station load**.",
            "Read the decision for 18:00–19:00: some are refused though a charger is free.",
            "Pick one of them under **Why was it refused?**",
        ),
        "From 18:00 to 19:00 the station draws nearly all the 61 kW that the transformer between "
        "633 and 634 leaves it, and not every charger is in use. Room on the feeder is scarce, not "
        "chargers. Try **Remove 2 chargers** and compare: what was not scarce is missed less.",
    ),
    Case(
        "What does an expensive afternoon do?",
        "price-spike",
        "Energy costs 1 to 1.56 $/kWh from 13:00 to 21:00; drivers pay a quarter to a third of it.",
        (
            "Press **Run to end** and look at **Charging schedule** and **Load and price**.",
            "Read why vehicles were refused in the afternoon.",
            "Choose **Ordinary** under **Energy price**, press **Reset** and run again.",
        ),
        "Hardly anybody charges between 13:00 and 20:00: a contract made before the spike is "
        "charged ahead of it, and those who would have to charge within it are refused because "
        "they pay less than their energy costs. On the ordinary day twice as many are admitted.",
    ),
    Case(
        "Whose limit is it: a line's, or a voltage?",
        "voltage-limited",
        "140 chargers, far more than ever needed, and a voltage at the feeder's far end.",
        (
            "Press **Step** until 18:00 and read **Limits by the hour** and the voltages.",
            "Choose **Full AC** under **Limits kept in**, press **Reset** and run to the end.",
        ),
        "In the evening the lowest voltage allowed at node 652 limits charging elsewhere on the "
        "feeder: current lowers the voltage on the way they share. The linearised model leaves "
        "out losses and so allows more. In full AC no room at all is left from 16:00 to 20:00, "
        "and far fewer vehicles are admitted.",
    ),
    Case(
        "What does a promise of speed cost?",
        "summer-weekday",
        "Option C1 pays more and is promised sooner; C2 pays less and may take longer.",
        (
            "Press **Step** until 15:00.",
            "Press **Everyone picks C1** and read before and after.",
            "Press **Undo**, set **C1 average** to 4.8 and run to the end.",
        ),
        "C1 brings in more for each kWh, but leaves the station fewer hours to choose from. Where "
        "room on the feeder is short in the evening, a later time of return lets more vehicles "
        "share it. Look at the pale windows in the schedule: their length is the promise.",
    ),
)
