# SPDX-License-Identifier: Apache-2.0
# Copyright The Dubsar developers
"""Dubsar's range grids, meshes and wedges as numpy arrays. Lengths are millimetres, angles radians.

Long calls let other threads run, report to ``progress(stage, fraction)`` on the calling thread, and stop when that
returns False, when it raises, or at Ctrl-C. Errors carry ``what``, ``where`` and ``mend``.
"""

from ._dubsar import *  # noqa: F401,F403
from ._dubsar import __version__  # noqa: F401
