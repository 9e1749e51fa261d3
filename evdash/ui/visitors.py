"""Who is at a tab, as far as sharing a server fairly needs it: an address, told to nobody.

No accounts, no cookies: a visitor is the network address that its pages come from, which costs
more to change than opening another tab does. Where a proxy on this machine passes pages on,
uvicorn takes the address that the proxy names (docs/deploy.md).
"""

import secrets
from hashlib import blake2b
from ipaddress import IPv6Address, ip_address, ip_network

import streamlit as st

HOUSE_BITS = 64
"""Of an IPv6 address, what stands for one house; it may choose the rest as it likes."""
_KEY = secrets.token_bytes(32)


def visitor() -> str | None:
    """Who is at this tab; None where nobody can be told from others, as on this machine itself."""
    return visitor_at(st.context.ip_address)


def visitor_at(host: str | None) -> str | None:
    """Who comes from an address: a name that tells visitors apart and says nothing of the address.

    It holds until the server is started again.
    """
    try:
        address = ip_address((host or "").partition("%")[0])
    except ValueError:
        return None
    if isinstance(address, IPv6Address):
        address = address.ipv4_mapped or address
    if address.is_loopback:
        return None
    if isinstance(address, IPv6Address):
        address = ip_network((address, HOUSE_BITS), strict=False).network_address
    return blake2b(address.packed, digest_size=16, key=_KEY).hexdigest()
