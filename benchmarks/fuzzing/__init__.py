"""Bad input by the tens of thousands: structure-aware, seeded, each with the outcome allowed."""
