// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

// DUBSAR_THREAD_SANITIZER is defined where this is built for the thread sanitizer. oneTBB's scheduler is a
// library that is not instrumented: the sanitizer would call every loop a race with what follows it. In that
// build loops run on plain threads.
#if defined(__SANITIZE_THREAD__)
#define DUBSAR_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define DUBSAR_THREAD_SANITIZER 1
#endif
#endif
