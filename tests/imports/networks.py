"""Small pandapower networks made for one purpose each."""

from typing import Any

import pandapower as pp

LINE = {"length_km": 2.0, "r_ohm_per_km": 0.3, "x_ohm_per_km": 0.35, "c_nf_per_km": 10.0}
TRAFO = {
    "sn_mva": 0.63,
    "vn_hv_kv": 20.0,
    "vn_lv_kv": 0.4,
    "vkr_percent": 1.2,
    "vk_percent": 6.0,
    "pfe_kw": 1.2,
    "i0_percent": 0.3,
    "shift_degree": 150.0,
}


def line(net: Any, start: int, end: int, **changes: Any) -> int:
    """A line of the usual kind."""
    values = LINE | {"max_i_ka": 0.2} | changes
    return int(pp.create_line_from_parameters(net, start, end, **values))


def two_levels(tap_pos: float = -2, tap_step_degree: float = 0.0) -> Any:
    """source ─ a ─ b (20 kV) ─▷ c ─ d (0.4 kV), with everything a balanced feeder can have."""
    net = pp.create_empty_network(name="two levels")
    source, a, b = (pp.create_bus(net, vn_kv=20.0, name=name) for name in ("source", "a", "b"))
    c, d = (pp.create_bus(net, vn_kv=0.4, name=name) for name in ("c", "d"))
    pp.create_ext_grid(net, source, vm_pu=1.02)
    line(net, source, a)
    line(net, b, a, parallel=2)
    pp.create_transformer_from_parameters(
        net,
        b,
        c,
        **TRAFO,
        tap_side="hv",
        tap_neutral=0,
        tap_min=-3,
        tap_max=3,
        tap_pos=tap_pos,
        tap_step_percent=2.5,
        tap_step_degree=tap_step_degree,
        tap_changer_type="Ratio",
    )
    line(net, c, d, length_km=0.1, c_nf_per_km=200.0, g_us_per_km=3.0)
    pp.create_load(net, a, p_mw=0.9, q_mvar=0.3, scaling=0.5, name="factory")
    pp.create_load(net, d, p_mw=0.15, q_mvar=0.05)
    pp.create_sgen(net, d, p_mw=0.04, q_mvar=-0.01)
    pp.create_storage(net, c, p_mw=-0.01, max_e_mwh=0.1)
    pp.create_shunt(net, a, q_mvar=-0.2, p_mw=0.01)
    pp.create_ward(net, b, ps_mw=0.02, qs_mvar=0.01, pz_mw=0.01, qz_mvar=0.005)
    return net


def ring(closed: bool) -> Any:
    """source ─ a ─ b ─ c ─ source, the line c ─ source behind a switch."""
    net = pp.create_empty_network(name="ring")
    buses = [pp.create_bus(net, vn_kv=20.0, name=name) for name in ("source", "a", "b", "c")]
    pp.create_ext_grid(net, buses[0])
    for start, end in ((0, 1), (1, 2), (2, 3)):
        line(net, buses[start], buses[end])
    back = line(net, buses[3], buses[0], name="back")
    pp.create_switch(net, buses[0], back, et="l", closed=closed)
    for bus in buses[1:]:
        pp.create_load(net, bus, p_mw=0.3, q_mvar=0.1)
    return net
