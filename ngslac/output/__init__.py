# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields, pictures and files of contact."""
