"""A race of policies, as tables, sentences and pictures."""

from dataclasses import dataclass

import pandas as pd

from evdash.charts.race import load_figure, price_figure, profit_figure
from evdash.charts.standalone import PlotlyFigure, as_plotly
from evdash.errors import Fault, InputError
from evdash.files.frames import table_frame
from evdash.files.race_folder import intervals_table, policies_table, refusals_table
from evdash.policies import race as policies
from evdash.policies.race_words import race_sentences


@dataclass(frozen=True, slots=True, repr=False)
class Race:
    """Several policies on the same day, made by `Scenario.race`.

    Attributes
    ----------
    data : evdash.policies.race.Race
        Everything there is of it: `laps` and `most_profit` among others.
    """

    data: policies.Race

    def __repr__(self) -> str:
        names = ", ".join(lap.policy for lap in self.data.laps)
        return f"<Race on {self.data.scenario!r}, {self.data.network}: {names}>"

    @property
    def figures(self) -> pd.DataFrame:
        """A row for each policy, a column for each figure, as `policies.csv`.

        Energies in kWh, money in $, shares from 0 to 1.
        """
        return table_frame(*policies_table(self.data)).set_index("policy")

    @property
    def intervals(self) -> pd.DataFrame:
        """Every interval under every policy, as `intervals.csv` of a race."""
        return _timed(table_frame(*intervals_table(self.data)))

    @property
    def refusals(self) -> pd.DataFrame:
        """Everyone a policy refused, with the reason it gave, as `refusals.csv`."""
        return _timed(table_frame(*refusals_table(self.data)))

    @property
    def sentences(self) -> tuple[str, ...]:
        """What foresight is worth, how much of it statistics give, who exceeds which limits."""
        return tuple(race_sentences(self.data))

    @property
    def most_profit(self) -> float | None:
        """What no policy within the limits can exceed, $; None where the oracle took no part."""
        return self.data.most_profit

    @property
    def absent(self) -> dict[str, str]:
        """Who could not take part, and why."""
        return dict(self.data.absent)

    def plot(self, kind: str = "profit") -> PlotlyFigure:
        """Draw the race.

        Parameters
        ----------
        kind : {"profit", "load", "capacity price"}
            Profits side by side; station load (kW) by the clock; what an hour's capacity was
            held to be worth to others ($/kWh), by the policies that price it.

        Returns
        -------
        plotly.graph_objects.Figure

        Raises
        ------
        InputError
            For a picture there is none of.

        Examples
        --------
        >>> import evdash
        >>> race = evdash.load("price-spike").race(["p1", "llf"])
        >>> race
        <Race on 'Price spike', lindistflow: p1, llf>
        >>> race.plot("load").layout.yaxis.title.text
        'Station load, kW'
        """
        names = [lap.policy for lap in self.data.laps]
        pricing = [lap.policy for lap in self.data.laps if any(lap.capacity_price_per_kwh)]
        pictures = {"profit": lambda: profit_figure(self.data)}
        pictures["load"] = lambda: load_figure(self.data, names)
        if pricing:
            pictures["capacity price"] = lambda: price_figure(self.data, pricing[0])
        if kind not in pictures:
            rule = f"should be one of {', '.join(pictures)}"
            raise InputError([Fault("kind", repr(kind), rule)])
        return as_plotly(pictures[kind]())


def _timed(table: pd.DataFrame) -> pd.DataFrame:
    return table.assign(start=pd.to_datetime(table["start"]).astype("datetime64[s]"))
