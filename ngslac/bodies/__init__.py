# SPDX-License-Identifier: LGPL-2.1-or-later
"""How bodies are held: their rigid motions, contact and friction."""
