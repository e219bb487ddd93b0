/// @file Marks loops over pixels and points: compiled for newer processors too, and chosen when the program
/// starts.
#pragma once

// Sanitizers instrument the choosing, which runs before they are set up.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CA2_HOT_LOOP __attribute__((target_clones("avx2", "default"), optimize("O3")))
#else
#define CA2_HOT_LOOP
#endif
