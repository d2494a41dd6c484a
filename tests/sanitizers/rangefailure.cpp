/// What a failed check calls: in place of the functions of ngcore and libstdc++, whose exception
/// could be caught, and whose message names no caller.

#include <core/exception.hpp>
#include <core/utils.hpp>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <execinfo.h>

namespace {
constexpr int most_frames = 40;

/// As the sanitizers print it; `addr2line -Cfie MODULE OFFSET` tells the line.
void PrintFrame(int number, const void *address) {
  Dl_info info{};
  dladdr(address, &info);
  std::string name = info.dli_sname ? ngcore::Demangle(info.dli_sname) : "";
  auto offset = static_cast<const char *>(address) - static_cast<const char *>(info.dli_fbase);
  std::fprintf(stderr, "    #%d %p in %s (%s+0x%zx)\n", number, address, name.c_str(),
               info.dli_fname, size_t(offset));
}

[[noreturn]] void Fail(const std::string & place, const std::string & what) {
  std::fprintf(stderr, "%s: runtime error: %s\n", place.c_str(), what.c_str());
  void *frames[most_frames];
  int count = backtrace(frames, most_frames);
  for (int i = 0; i < count; i++)
    PrintFrame(i, frames[i]);
  std::abort();
}
} // namespace

namespace ngcore {
void ThrowRangeException(const char *place, ptrdiff_t index, ptrdiff_t first, ptrdiff_t next) {
  Fail(place, "index " + std::to_string(index) + " is not in [" + std::to_string(first) + ", " +
                  std::to_string(next) + ")");
}
} // namespace ngcore

namespace std {
void __glibcxx_assert_fail(const char *file, int line, const char *, const char *what) noexcept {
  Fail(string(file) + ":" + to_string(line), what);
}
} // namespace std
