// AES-128 CMAC (RFC 4493, NIST SP 800-38B), computed by OpenSSL.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "common/result.h"

struct evp_mac_ctx_st;

namespace bevloc::can {

using SecocKey = std::array<uint8_t, 16>;

/// Does not allocate after construction. One thread.
class Cmac {
 public:
  using Tag = std::array<uint8_t, 16>;

  /// Fails when OpenSSL has no CMAC or no AES-128.
  static Result<Cmac> create(const SecocKey& key);

  /// Returns false when OpenSSL fails. `tag` is then undefined.
  bool compute(std::span<const uint8_t> message, Tag& tag);

 private:
  struct Free {
    void operator()(evp_mac_ctx_st* context) const;
  };
  explicit Cmac(std::unique_ptr<evp_mac_ctx_st, Free> context) : context_(std::move(context)) {}

  std::unique_ptr<evp_mac_ctx_st, Free> context_;
};

}  // namespace bevloc::can
