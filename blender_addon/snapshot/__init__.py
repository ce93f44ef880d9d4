"""From Blender's data to the files of a scene folder."""
