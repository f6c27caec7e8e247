"""Pictures of trials: they know arrays and their own panels, nothing of files, runs or the arm."""
