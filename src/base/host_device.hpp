// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Marks functions that a compiler for GPUs also compiles for the device; empty elsewhere.
#ifdef __CUDACC__
#define SLIPFRONT_HOST_DEVICE __host__ __device__
#else
#define SLIPFRONT_HOST_DEVICE
#endif
