"""Choosing a motion: the three-phase planner, its margins, and the limits that name themselves."""
