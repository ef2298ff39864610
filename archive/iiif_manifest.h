// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace dubsar {

/// A picture to be shown on a canvas of its own.
struct ManifestPicture {
  std::string path;  ///< relative to Manifest::base_url
  std::string label;
  std::string media_type;  ///< "image/png", "image/jpeg"
  int width = 0;
  int height = 0;
  double mm_per_px = 0;       ///< 0: not to scale
  std::string annotations{};  ///< the page of what is said about places on it, relative likewise; empty: none
};

/// Another file of the object, for the links of a manifest.
struct ManifestLink {
  std::string path;
  std::string label;
  std::string type;        ///< of the IIIF registry: "Model", "Dataset", "Text"
  std::string media_type;  ///< "model/gltf-binary"
};

struct ManifestInput {
  std::string base_url;  ///< ends with a slash
  std::string label;
  std::string summary;
  std::vector<std::pair<std::string, std::string>> metadata;  ///< label, value; empty values are left out
  std::string rights{};  ///< in words; shown with every picture, and as `rights` where it holds an address
  std::vector<ManifestPicture> pictures;
  std::vector<ManifestLink> rendering;  ///< for people
  std::vector<ManifestLink> see_also;   ///< for machines
};

/// The id of the canvas of a picture, counted from 0.
[[nodiscard]] std::string canvas_id(const std::string& base_url, std::size_t picture);

/// A IIIF Presentation 3.0 manifest: one canvas a picture, as large as the picture, with its scale as a
/// physical dimensions service.
[[nodiscard]] std::string iiif_manifest(const ManifestInput& input);

}  // namespace dubsar
