"""The place of the Blender extension: panels and operators only, no physics."""
