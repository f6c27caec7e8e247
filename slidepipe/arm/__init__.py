"""The 7-DOF Barrett WAM: its model, its inverse kinematics and its inverse dynamics."""
