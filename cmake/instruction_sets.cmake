# For which instruction sets kernels are compiled. Highway takes the best of them that the machine has; AVX2 and
# AVX-512 give equal results. `native` leaves SSE2, which every machine has, and the best of this one: half of the
# work, and as fast here. SSSE3 and AVX3_DL give kernels like ours nothing over SSE2 and AVX3. Sanitized kernels
# take minutes to compile; two sets are enough to test.
set(TAFONI_INSTRUCTION_SETS all CACHE STRING "Kernels for `all` instruction sets, or `native`: this machine's best")
if(NOT TAFONI_INSTRUCTION_SETS MATCHES "^(all|native)$")
  message(FATAL_ERROR "TAFONI_INSTRUCTION_SETS is all or native, not ${TAFONI_INSTRUCTION_SETS}")
endif()

set(sets_off HWY_SSSE3 HWY_AVX3_DL)
if(TAFONI_SANITIZE)
  list(APPEND sets_off HWY_SSE4 HWY_AVX3)
elseif(TAFONI_INSTRUCTION_SETS STREQUAL "native" AND EXISTS /proc/cpuinfo)
  file(STRINGS /proc/cpuinfo cpu_flags REGEX "^flags" LIMIT_COUNT 1) # x86 alone has a line of this name
  if(cpu_flags MATCHES " avx512f .*avx512bw .*avx512vl ")
    list(APPEND sets_off HWY_SSE4 HWY_AVX2)
  elseif(cpu_flags MATCHES " avx2 ")
    list(APPEND sets_off HWY_SSE4 HWY_AVX3)
  elseif(cpu_flags MATCHES " sse4_2 ")
    list(APPEND sets_off HWY_AVX2 HWY_AVX3)
  endif()
endif()
list(JOIN sets_off "|" sets_off)
add_compile_definitions("HWY_DISABLED_TARGETS=(${sets_off})")
