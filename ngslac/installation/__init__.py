# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is installed, and whether it works."""
