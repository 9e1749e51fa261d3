"""Every word of the field that the app uses, explained once; tooltips and the Model page read it.

Texts are plain words without mark-up.
"""

from collections.abc import Mapping

GLOSSARY: Mapping[str, str] = {
    "AC power flow": "The full calculation of voltages and losses in an alternating-current "
    "network. Slower than the linearised model and nearer the truth; here it checks every hour "
    "that was executed.",
    "Admitted": "Given a contract: the vehicle will be charged as asked and in time.",
    "Aggregator": "Whoever runs the charging station: buys energy, sells charging, answers for "
    "the limits of the feeder.",
    "Binding": "A limit is binding where it, and no other, decides how much may be charged.",
    "Bound": "A figure that no plan can beat, proven by the optimiser. The nearer a plan is to "
    "it, the less could be gained by searching on.",
    "Contract": "The promise to a driver: this much energy, back by this time. Once made it is "
    "kept whatever comes.",
    "Deadline": "The time of return that was promised; the charge is complete by then.",
    "DistFlow, linearised": "The paper's model of the feeder: voltages fall in proportion to the "
    "power that flows; losses are left out. Also called LinDistFlow.",
    "Feeder": "The line with its branches from a substation to its customers. Radial: there is "
    "one way only from the substation to every node.",
    "Fallback": "The rest of the plan before, with nobody new: used where the optimiser had "
    "nothing better in time. It keeps every contract.",
    "Gap": "How far a plan is, at most, from the best there can be, in dollars.",
    "Headroom": "The most the station may draw in an interval without exceeding a limit of the "
    "feeder, in kW; 0 where the feeder by itself exceeds one that charging would worsen.",
    "Horizon": "The whole time that is planned, usually a day. Moving horizon: the plan for "
    "the rest of it is made anew in every interval.",
    "Interval": "The step in which the day is decided, usually an hour.",
    "kVA": "Apparent power, the measure of what lines and transformers carry: active power (kW) "
    "and reactive power (kvar) at right angles to each other.",
    "MILP": "Mixed-integer linear program: minimise a sum under linear limits, where some "
    "unknowns must be whole numbers. Here those are yes or no to a vehicle, and a charger's on "
    "or off.",
    "Node": "A point of the feeder where lines meet or customers are connected; also called bus.",
    "Option": "What a driver can choose: a price for each kWh, and with it how fast the charge "
    "is promised. C1 is dearer and faster than C2.",
    "P1": "The paper's optimisation problem, solved once in every interval: equations (1) to (9) "
    "under one objective.",
    "PEV": "Plug-in electric vehicle: a car that is charged from the grid, wholly or in part.",
    "Power factor": "Active power as a share of apparent power; below 1 a load needs reactive "
    "power besides. Lagging: as motors do.",
    "Preset": "A scenario that comes with the program.",
    "Proven optimal": "The plan is within one cent of a bound that no plan can beat.",
    "pu": "Per unit: as a share of the nominal value. 0.97 pu is 97 % of the nominal voltage.",
    "Rating": "The most that a line, a transformer or a node is built to carry, in kVA.",
    "Reactive power": "Power that swings to and fro without doing work, in kvar. It takes up room "
    "in lines and lowers voltages; capacitors supply it on the spot.",
    "Refused": "Turned down at once, with a reason; nothing is promised.",
    "Scenario": "Everything that decides a day: feeder, station, prices, loads, and who arrives.",
    "Seed": "The number random arrivals are drawn from: the same seed gives the same vehicles.",
    "State of charge (SOC)": "How full a battery is, from 0 to 1 or in per cent.",
    "Substation": "Where the feeder is supplied; its voltage is held.",
    "Tail": "What is left of the last plan after the interval just executed. It is always a "
    "valid plan for those under contract.",
    "Transformer": "Steps the voltage down to what customers use; its rating is often the first "
    "limit that charging meets.",
    "Voltage limits": "The range in which every node's voltage must stay. The paper keeps 3 per "
    "cent up and down at the distribution transformers.",
}


def meaning(term: str) -> str:
    """What a term means, for a tooltip."""
    return GLOSSARY[term]
