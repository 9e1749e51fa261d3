"""The tables of a pandapower network that are read, one record for each kind of element.

Columns and units are pandapower's. Columns that are not named here bear on nothing a balanced
power flow computes; of these, limits are kept aside to be told, and the others passed over.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

LARGEST = 1e9
SMALLEST = 0.0001
"""Of what stands below a fraction line: less is no size of anything built."""


def _null_to_default(default: Any) -> BeforeValidator:
    return BeforeValidator(lambda value: default if value is None else value)


def _text_or_none(value: object) -> object:
    return None if value is None else str(value)


Size = Annotated[float, Field(ge=0, le=LARGEST)]
Positive = Annotated[float, Field(ge=SMALLEST, le=LARGEST)]
Kilovolt = Annotated[float, Field(ge=0.01, le=2000)]
PerUnit = Annotated[float, Field(ge=0.5, le=1.5)]
Percent = Annotated[float, Field(ge=0, le=100), _null_to_default(0.0)]
TapStep = Annotated[float, Field(ge=-1000, le=1000)]
TapPercent = Annotated[float, Field(ge=-100, le=100)]
Signed = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Zero = Annotated[Signed, _null_to_default(0.0)]
SizeOrZero = Annotated[Size, _null_to_default(0.0)]
One = Annotated[Signed, _null_to_default(1.0)]
Share = Annotated[Positive, _null_to_default(1.0)]
Half = Annotated[Signed, _null_to_default(0.5)]
Count = Annotated[int, Field(ge=1, le=1000), _null_to_default(1)]
Yes = Annotated[bool, _null_to_default(True)]
No = Annotated[bool, _null_to_default(False)]
Text = Annotated[str | None, BeforeValidator(_text_or_none)]


class Element(BaseModel):
    """What every element has: its row's index and, maybe, a name.

    `unheld` are the limits a row has that a scenario cannot hold, by column.
    """

    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)

    index: int
    name: Text = None
    in_service: Yes = True
    unheld: Mapping[str, float] = Field(default_factory=dict)

    def told(self, table: str) -> str:
        """The element as a person finds it, `line 12 'Line 6-7'`."""
        return f"{table} {self.index}" + (f" {self.name!r}" if self.name else "")


class Bus(Element):
    """A bus; its position as drawn, where the file has one."""

    vn_kv: Kilovolt
    min_vm_pu: Size | None = None
    max_vm_pu: Size | None = None
    x: Signed | None = None
    y: Signed | None = None


class Line(Element):
    """A line as π-equivalent of `parallel` equal systems."""

    from_bus: int
    to_bus: int
    length_km: Size
    r_ohm_per_km: Size
    x_ohm_per_km: Size
    c_nf_per_km: SizeOrZero = 0.0
    g_us_per_km: SizeOrZero = 0.0
    max_i_ka: Size | None = None
    max_loading_percent: Positive | None = None
    df: Share = 1.0
    parallel: Count = 1


class Trafo(Element):
    """A two-winding transformer, `parallel` equal ones."""

    hv_bus: int
    lv_bus: int
    sn_mva: Positive
    vn_hv_kv: Kilovolt
    vn_lv_kv: Kilovolt
    vk_percent: Positive
    vkr_percent: SizeOrZero = 0.0
    pfe_kw: SizeOrZero = 0.0
    i0_percent: SizeOrZero = 0.0
    shift_degree: Zero = 0.0
    tap_side: Literal["hv", "lv"] | None = None
    tap_neutral: TapStep | None = None
    tap_pos: TapStep | None = None
    tap_step_percent: TapPercent | None = None
    tap_step_degree: Signed | None = None
    tap_changer_type: Text = None
    tap_dependency_table: No = False
    tap2_pos: TapStep | None = None
    tap2_neutral: TapStep | None = None
    leakage_resistance_ratio_hv: Half = 0.5
    leakage_reactance_ratio_hv: Half = 0.5
    max_loading_percent: Positive | None = None
    df: Share = 1.0
    parallel: Count = 1


class Power(Element):
    """Power drawn or fed in at a bus."""

    bus: int
    p_mw: Signed
    q_mvar: Zero = 0.0
    scaling: One = 1.0


class Load(Power):
    """A load; shares of constant impedance and constant current in percent."""

    const_z_p_percent: Percent = 0.0
    const_i_p_percent: Percent = 0.0
    const_z_q_percent: Percent = 0.0
    const_i_q_percent: Percent = 0.0

    @property
    def depends_on_voltage(self) -> bool:
        shares = (self.const_z_p_percent, self.const_i_p_percent)
        return any((*shares, self.const_z_q_percent, self.const_i_q_percent))


class Shunt(Element):
    """Constant impedance at a bus, its powers at `vn_kv` and for one step."""

    bus: int
    p_mw: Zero = 0.0
    q_mvar: Zero = 0.0
    vn_kv: Kilovolt | None = None
    step: One = 1.0
    step_dependency_table: No = False


class Ward(Element):
    """A ward equivalent: constant power and constant impedance."""

    bus: int
    ps_mw: Zero = 0.0
    qs_mvar: Zero = 0.0
    pz_mw: Zero = 0.0
    qz_mvar: Zero = 0.0


class Switch(Element):
    """A switch between two buses (`b`) or at the end of a line (`l`) or transformer (`t`)."""

    bus: int
    element: int
    et: Literal["b", "l", "t", "t3"]
    closed: Yes = True
    z_ohm: SizeOrZero = 0.0


class ExtGrid(Element):
    """Where the network is supplied, at a voltage held."""

    bus: int
    vm_pu: Annotated[PerUnit, _null_to_default(1.0)] = 1.0


class Other(Element):
    """An element of a kind a scenario cannot carry."""

    table: str


RECORDS: dict[str, type[Element]] = {
    "bus": Bus,
    "line": Line,
    "trafo": Trafo,
    "load": Load,
    "sgen": Power,
    "storage": Power,
    "shunt": Shunt,
    "ward": Ward,
    "switch": Switch,
    "ext_grid": ExtGrid,
}
"""Tables that are read. All others with elements in service are refused by name."""


class Net(BaseModel):
    """A network as read: the tables above and, by name, whatever else is in service."""

    model_config = ConfigDict(frozen=True)

    name: str
    f_hz: Positive = 50.0
    sn_mva: Positive = 1.0
    bus: tuple[Bus, ...]
    line: tuple[Line, ...] = ()
    trafo: tuple[Trafo, ...] = ()
    load: tuple[Load, ...] = ()
    sgen: tuple[Power, ...] = ()
    storage: tuple[Power, ...] = ()
    shunt: tuple[Shunt, ...] = ()
    ward: tuple[Ward, ...] = ()
    switch: tuple[Switch, ...] = ()
    ext_grid: tuple[ExtGrid, ...] = ()
    others: tuple[Other, ...] = ()
