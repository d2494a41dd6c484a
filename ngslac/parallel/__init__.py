# SPDX-License-Identifier: LGPL-2.1-or-later
"""Distributed meshes: contact surfaces that all processes have, and arrays that they share."""
