# SPDX-License-Identifier: LGPL-2.1-or-later
"""What touches: the contact condition of two surfaces, and what is known of it."""
