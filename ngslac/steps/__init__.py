# SPDX-License-Identifier: LGPL-2.1-or-later
"""Load steps, time steps, and saved states."""
