"""Why a vehicle was refused, what would have admitted it, what a day's limits are worth."""
