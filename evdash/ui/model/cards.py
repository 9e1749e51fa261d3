"""P1 equation by equation, in the groups the page shows."""

from evdash.ui.model.clock_cards import CLOCK
from evdash.ui.model.contract_cards import CONTRACTS
from evdash.ui.model.feeder_cards import FEEDER
from evdash.ui.model.station_cards import STATION

GROUPS = {
    "The feeder": FEEDER,
    "The contracts": CONTRACTS,
    "The station, and what is optimised": STATION,
    "From a request to a contract, and from hour to hour": CLOCK,
}
