# SPDX-License-Identifier: LGPL-2.1-or-later
"""How contact is looked at: fields, pictures, files."""
