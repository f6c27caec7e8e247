"""A program for the control PC of a WAM, in C++, and what of it is tested here: see its README."""
