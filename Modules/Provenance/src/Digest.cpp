// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Digest.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"

#include <openssl/evp.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

namespace explica::provenance {
namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) {
      throw EnvironmentError("OpenSSL offers no SHA-256");
    }
  }
  void add(const void* bytes, std::size_t count) { EVP_DigestUpdate(context_.get(), bytes, count); }
  std::string hex() {
    unsigned char raw[EVP_MAX_MD_SIZE];
    unsigned int count = 0;
    EVP_DigestFinal_ex(context_.get(), raw, &count);
    constexpr const char* kDigits = "0123456789abcdef";
    std::string text;
    for (unsigned int i = 0; i < count; ++i) {
      text += kDigits[raw[i] >> 4];
      text += kDigits[raw[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

constexpr std::size_t kLargestBlock = std::size_t{1} << 20;  // bytes read at a time
constexpr std::size_t kCheckEvery = 64 * kLargestBlock;      // a tenth of a second's work

}  // namespace

Digest digestOf(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& cause) {
    throw IOError(file.string() + ": " + cause);
  };
  std::error_code fault;
  const auto status = std::filesystem::status(file, fault);
  if (status.type() == std::filesystem::file_type::not_found) refuse("no such file");
  if (fault) refuse("cannot be read (" + fault.message() + ")");
  if (std::filesystem::is_directory(status)) refuse("is a folder; a file is needed");
  if (!std::filesystem::is_regular_file(status)) refuse("is not a regular file");

  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                               &std::fclose);
  if (!stream) refuse(std::string("cannot be read (") + std::strerror(errno) + ")");
  Sha256 hash;
  Digest digest;
  const auto size = std::filesystem::file_size(file, fault);
  std::vector<unsigned char> block(fault || size >= kLargestBlock ? kLargestBlock : size + 1);
  std::size_t count = 0;
  while ((count = std::fread(block.data(), 1, block.size(), stream.get())) > 0) {
    hash.add(block.data(), count);
    digest.size += count;
    if (digest.size % kCheckEvery == 0) checkpoint();
  }
  if (std::ferror(stream.get()))
    refuse(std::string("cannot be read (") + std::strerror(errno) + ")");
  digest.sha256 = hash.hex();
  return digest;
}

std::string sha256Of(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

}  // namespace explica::provenance
