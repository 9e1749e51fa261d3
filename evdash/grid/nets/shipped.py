"""Networks that come with pandapower, by name, as the JSON text it writes of them."""

from collections.abc import Mapping

SHIPPED: Mapping[str, str] = {
    "case33bw": "Baran and Wu's 33-bus feeder, 12.66 kV",
    "cigre_mv": "CIGRE European medium-voltage benchmark, 110/20 kV",
    "cigre_mv_pv_wind": "the same with photovoltaics and wind",
    "cigre_lv": "CIGRE European low-voltage benchmark, 20/0.4 kV",
    "mv_oberrhein": "a German 20 kV network with two supplies",
    "mv_open_ring": "a small 110/20 kV open ring",
    "dickert_lv": "a short low-voltage feeder after Dickert",
    "kerber_dorfnetz": "Kerber's village network, 10/0.4 kV",
    "kerber_landnetz_freileitung_1": "Kerber's rural overhead network 1, 10/0.4 kV",
    "kerber_landnetz_freileitung_2": "Kerber's rural overhead network 2, 10/0.4 kV",
    "kerber_landnetz_kabel_1": "Kerber's rural cable network 1, 10/0.4 kV",
    "kerber_landnetz_kabel_2": "Kerber's rural cable network 2, 10/0.4 kV",
    "kerber_vorstadtnetz_kabel_1": "Kerber's suburban cable network 1, 10/0.4 kV",
    "kerber_vorstadtnetz_kabel_2": "Kerber's suburban cable network 2, 10/0.4 kV",
    "four_loads": "four loads with branches, 10/0.4 kV",
    "four_bus": "four buses with two generators, 10/0.4 kV",
}
"""Radial as pandapower ships them; the name here and what it is."""

MAKERS: Mapping[str, str] = {
    "case33bw": "case33bw",
    "cigre_mv": "create_cigre_network_mv",
    "cigre_mv_pv_wind": "create_cigre_network_mv",
    "cigre_lv": "create_cigre_network_lv",
    "mv_oberrhein": "mv_oberrhein",
    "mv_open_ring": "simple_mv_open_ring_net",
    "dickert_lv": "create_dickert_lv_network",
    "four_loads": "four_loads_with_branches_out",
    "four_bus": "simple_four_bus_system",
}
"""pandapower's function for each; Kerber's are `create_` and the name."""


def shipped_json(name: str) -> bytes:
    """A shipped network as pandapower writes it to a file; `name` is a key of SHIPPED."""
    import warnings

    import pandapower
    import pandapower.networks

    make = getattr(pandapower.networks, MAKERS.get(name, f"create_{name}"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # pandapower's, on files of its own in an older form
        net = make(with_der="pv_wind") if name == "cigre_mv_pv_wind" else make()
        net.name = name
        return str(pandapower.to_json(net)).encode()
