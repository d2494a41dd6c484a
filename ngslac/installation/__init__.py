# SPDX-License-Identifier: LGPL-2.1-or-later
"""Installed versions, and a check that they work."""
