# SPDX-License-Identifier: LGPL-2.1-or-later
"""How a computation is driven: loads, time, and what is written down to go on later."""
