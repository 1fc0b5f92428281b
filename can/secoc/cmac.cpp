#include "can/secoc/cmac.h"

#include <openssl/core_names.h>
#include <openssl/evp.h>
#include <openssl/params.h>

namespace bevloc::can {

void Cmac::Free::operator()(evp_mac_ctx_st* context) const {
  EVP_MAC_CTX_free(context);
}

Result<Cmac> Cmac::create(const SecocKey& key) {
  EVP_MAC* mac = EVP_MAC_fetch(nullptr, "CMAC", nullptr);
  std::unique_ptr<evp_mac_ctx_st, Free> context(mac == nullptr ? nullptr : EVP_MAC_CTX_new(mac));
  EVP_MAC_free(mac);  // the context keeps its own reference
  char cipher[] = "AES-128-CBC";
  const OSSL_PARAM parameters[] = {
      OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_CIPHER, cipher, 0), OSSL_PARAM_END};
  if (!context || EVP_MAC_init(context.get(), key.data(), key.size(), parameters) != 1) {
    return fail("OpenSSL: found no CMAC with AES-128, wanted OpenSSL 3 with its default provider");
  }
  return Cmac(std::move(context));
}

bool Cmac::compute(std::span<const uint8_t> message, Tag& tag) {
  size_t length = 0;
  return EVP_MAC_init(context_.get(), nullptr, 0, nullptr) == 1 &&
         EVP_MAC_update(context_.get(), message.data(), message.size()) == 1 &&
         EVP_MAC_final(context_.get(), tag.data(), &length, tag.size()) == 1 &&
         length == tag.size();
}

}  // namespace bevloc::can
