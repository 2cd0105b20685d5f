"""Contacts of rigid bodies in mode `exact`: located impacts, and what rests, rolls or slides as rows of forces."""
