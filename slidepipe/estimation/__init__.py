"""From what the cameras saw to clock, smoothed poses, slide, resting grasp and friction, each with its uncertainty."""
