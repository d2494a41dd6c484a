# SPDX-License-Identifier: LGPL-2.1-or-later
"""What holds bodies: their rigid motions, contact, friction, and nothing else."""
