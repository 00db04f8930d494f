#pragma once

// A function marked BATTEN_VECTOR_CLONES is compiled for several vector widths; the machine's best
// is chosen when the program starts. Its loops must reduce in fixed lanes, so that every width
// gives the same bits. Sanitizers do not stand the early start-up code that this needs.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BATTEN_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define BATTEN_VECTOR_CLONES
#endif
