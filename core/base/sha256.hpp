#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>

struct evp_md_ctx_st;  // OpenSSL's EVP_MD_CTX

namespace tomodem {

/// SHA-256 of bytes that come in pieces (FIPS 180-4).
class Sha256 {
 public:
    Sha256();
    void add(std::span<const std::byte> bytes);
    /// All bytes of the values of a container, in order.
    template <class Values>
    void add_all(const Values& values) {
        add(std::as_bytes(std::span(values)));
    }
    /// 64 hexadecimal digits; nothing can be added afterwards.
    std::string hexadecimal();

 private:
    struct Free {
        void operator()(evp_md_ctx_st* context) const;
    };
    std::unique_ptr<evp_md_ctx_st, Free> context_;
};

}  // namespace tomodem
