"""The paper's figures that can be drawn, by the names that the command line takes. Imports nothing."""

TITLES = {
    "fig01": "Finger and object in the 1-DOF problem",
    "fig02": "What wrong friction does to the slide",
    "fig03": "An object in a two-fingered pinch",
    "fig04": "The limit surface of a soft finger",
    "fig05": "Four fingers and their grasp limit surface",
    "fig06": "The relative motion of the slide",
    "fig07": "Friction on the limit surface while it slides",
    "fig08": "Trajectories of object and finger",
    "fig10": "How the arm followed its reference",
    "fig11": "How the finger slid on the object",
    "fig12": "Repeated trials in the space of the relative pose",
}
"""Names and what each shows; Fig. 9 is a photograph."""

CAPTIONS = "captions.md"
"""The page with all captions, beside the figures."""
