#include <isa-l/igzip_lib.h>

#include "gzip_inflater.h"

namespace foucault::rawlog {
namespace {

/// The checksum of ISA-L leaves the upper halves of vector registers of x86 in use, which makes
/// every SSE instruction after it wait for them: a sine took 20 times as long.
#if defined(__x86_64__)
[[gnu::target("avx")]] void release_upper_halves() { __builtin_ia32_vzeroupper(); }
bool has_upper_halves() { return __builtin_cpu_supports("avx") != 0; }
#else
void release_upper_halves() {}
bool has_upper_halves() { return false; }
#endif

class IsalInflater final : public GzipInflater {
 public:
  IsalInflater() {
    isal_inflate_init(&state_);
    state_.crc_flag = ISAL_GZIP;
  }

  void reset() override {
    isal_inflate_reset(&state_);
    state_.crc_flag = ISAL_GZIP;
  }

  State inflate(Bytes& input, unsigned char*& out, const unsigned char* end) override {
    state_.next_in = const_cast<unsigned char*>(input.begin);  // it does not write there
    state_.avail_in = static_cast<uint32_t>(input.size());
    state_.next_out = out;
    state_.avail_out = static_cast<uint32_t>(end - out);
    const int result = isal_inflate(&state_);
    if (has_upper_halves_) release_upper_halves();
    input.begin = state_.next_in;
    out = state_.next_out;
    if (result != ISAL_DECOMP_OK && result != ISAL_END_INPUT) return State::damaged;
    return state_.block_state == ISAL_BLOCK_FINISH ? State::member_ends : State::within;
  }

 private:
  inflate_state state_{};
  bool has_upper_halves_ = has_upper_halves();
};

}  // namespace

std::unique_ptr<GzipInflater> isal_inflater() { return std::make_unique<IsalInflater>(); }

}  // namespace foucault::rawlog
