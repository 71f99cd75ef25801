"""From what was given to a scene: poses and layouts are found where there are images and none."""
