"""The part of the experiment file that says how trials follow each other."""

from typing import Annotated, Literal

from pydantic import Field

from slidepipe.artifacts.schema import Data, Record

Way = Literal["goal", "posterior", "learned"]
"""What a trial changes in the next plan: the goal alone (the paper's); the goal and the friction, pooled over all
trials; or these and the arm, whose real masses and joint friction the trials tell."""


class Iteration(Record):
    """How often to try, what to learn from a trial, and how many in a row may bring nothing before it is given up."""

    max_trials: Annotated[int, Field(ge=1, le=100)]
    way: Way
    patience: Annotated[int, Field(ge=1, le=100)] = 3


def upcast_iteration(data: Data) -> Data:
    """Version 1 said ``friction: estimate`` or ``keep``: the pooled friction, or the goal alone."""
    iteration = data.get("iteration")
    if not isinstance(iteration, dict) or "friction" not in iteration:
        return data
    kept = {key: value for key, value in iteration.items() if key != "friction"}
    ways = {"estimate": "posterior", "keep": "goal"}
    friction = iteration["friction"]
    return {**data, "iteration": {**kept, "way": ways.get(friction, friction)}}
