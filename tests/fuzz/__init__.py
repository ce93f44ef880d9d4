"""Valid small inputs, mutated: readers must read them or say what is wrong, soon and in little memory."""
