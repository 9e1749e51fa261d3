"""Days held against each other."""

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from evdash.api.days import Day
from evdash.charts.comparison import QUANTITIES, Compared, overlay_figure
from evdash.charts.standalone import PlotlyFigure, as_plotly
from evdash.errors import Fault, InputError
from evdash.files.differences import scenario_differences


def compare(days: Mapping[str, Day]) -> "Comparison":
    """Hold days against the first of them.

    Parameters
    ----------
    days : mapping of str to Day
        Days under the names they are to be told by.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        For fewer than two days.

    Examples
    --------
    >>> import evdash
    >>> scenario = evdash.load("summer-weekday")
    >>> half = scenario.replace({"station.chargers": 6})
    >>> found = evdash.compare({"twelve": scenario.run(), "six": half.run()})
    >>> found.inputs
                   what twelve six
    0  station.chargers     12   6
    >>> found.figures.loc[["admitted"], ["twelve", "six", "six less twelve"]]
              twelve   six  six less twelve
    admitted    51.0  35.0            -16.0
    """
    if len(days) < 2:
        raise InputError([Fault("days", f"{len(days)}", "should be two or more")])
    return Comparison(dict(days))


@dataclass(frozen=True, slots=True, repr=False)
class Comparison:
    """Days held against each other, made by `compare`.

    Attributes
    ----------
    days : dict of str to Day
        The first is what the others are held against.
    """

    days: dict[str, Day]

    def __repr__(self) -> str:
        return f"<Comparison of {', '.join(self.days)}>"

    @property
    def figures(self) -> pd.DataFrame:
        """A row for each figure of `Day.figures`, a column for each day, and for its difference."""
        first, *others = self.days
        told = self.days[first].figures[["label", "unit"]]
        values = {name: day.figures["value"] for name, day in self.days.items()}
        apart = {f"{name} less {first}": values[name] - values[first] for name in others}
        return told.assign(**values, **apart)

    @property
    def inputs(self) -> pd.DataFrame:
        """What differs between the scenarios: a row for each setting or column of a table."""
        first, *others = self.days
        given = {name: day.trace.inputs.given for name, day in self.days.items()}
        rows: dict[str, dict[str, str]] = {}
        for name in others:
            for one in scenario_differences(given[first], given[name]):
                rows.setdefault(one.place, {"what": one.place, first: one.before})[name] = one.after
        return pd.DataFrame(list(rows.values()), columns=["what", *self.days])

    def plot(self, quantity: str = "Station load") -> PlotlyFigure:
        """Draw one quantity of every day over the clock.

        Parameters
        ----------
        quantity : str, default "Station load"
            One of "Station load", "Headroom", "Energy price", "Admitted", "Refused",
            "Lowest voltage".

        Returns
        -------
        plotly.graph_objects.Figure

        Raises
        ------
        InputError
            For another quantity.
        """
        if quantity not in QUANTITIES:
            rule = f"should be one of {', '.join(QUANTITIES)}"
            raise InputError([Fault("quantity", repr(quantity), rule)])
        drawn = [Compared(name, day.trace, day.outlook) for name, day in self.days.items()]
        return as_plotly(overlay_figure(drawn, quantity))
