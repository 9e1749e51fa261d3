"""A policy of one's own: whoever pays most first, in the cheapest hours that are left."""

import numpy as np


def policy(snapshot):
    """Power in kW in every slot, of every vehicle that is to be admitted, by its name."""
    hours = snapshot.interval_hours
    room_kw = snapshot.headroom_kw - snapshot.tail_kw.sum(axis=0)  # what contracts leave
    free = snapshot.chargers - (snapshot.tail_kw > 0).sum(axis=0)
    answer = {}
    for request in sorted(snapshot.requests, key=lambda one: -one.price_per_kwh):
        slots = range(request.deadline_interval - snapshot.now)
        least_kw = min(request.min_kw, request.need_kwh / hours)
        power_kw = np.zeros(snapshot.n_slots)
        missing_kw = request.need_kwh / hours  # as if in a single slot
        for slot in sorted(slots, key=lambda slot: snapshot.price_per_kwh[slot]):
            most_kw = min(request.max_kw, room_kw[slot], missing_kw)
            if 0 < missing_kw - most_kw < least_kw:
                most_kw = missing_kw - least_kw  # a rest too small for a charger helps nobody
            if free[slot] > 0 and most_kw >= least_kw:
                power_kw[slot] = most_kw
                missing_kw -= most_kw
        cost = snapshot.tariff.cost(power_kw)
        if request.refusal or missing_kw > 1e-9 or cost >= request.revenue:
            continue  # refused
        answer[request.vehicle] = power_kw
        room_kw = room_kw - power_kw
        free = free - (power_kw > 0)
    return answer
