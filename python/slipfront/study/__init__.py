# SPDX-License-Identifier: BSD-3-Clause
"""Studies: a case over its numerical parameters, which is a sweep, and the limits of its front speeds."""
