// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "files/toml_reader.h"

namespace dts::fleet::s3 {

/// A bucket, as configured.
struct Settings {
  std::string endpoint;  ///< "https://s3.example.org"; http only at a loopback address. Addressing is path-style: ENDPOINT/BUCKET/KEY.
  std::string bucket;
  std::string region;            ///< As the signature has it: "eu-west-2"; many servers of one's own accept any.
  std::string credentials_file;  ///< See `read_credentials`.
  std::string ca_file;           ///< Certificates of the authority that signed the server's: no other counts. Empty: those of the system.
};

struct Credentials {
  std::string access_key;
  std::string secret_key;
};

/// Reads the table s3 = { endpoint, bucket, region, credentials, ca }. Adds errors to the reader's problems. Names of files are relative to
/// its file.
[[nodiscard]] Settings read_settings(files::TomlReader reader);

/// Reads a file of two lines: the access key's ID, the secret key. Fails with NotAllowed if others can read it, and with InvalidArgument.
[[nodiscard]] core::Result<Credentials> read_credentials(const std::string& file);

}  // namespace dts::fleet::s3
