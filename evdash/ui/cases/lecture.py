"""The cases prepared for the lecture, in their order."""

from evdash.ui.cases.scarcity import SCARCE
from evdash.ui.cases.speed import SPEED
from evdash.ui.cases.spike import SPIKE
from evdash.ui.cases.voltage import VOLTAGE

CASES = (SCARCE, SPIKE, VOLTAGE, SPEED)
