// Reads campaign files. docs/campaigns.md is their reference, docs/campaign.schema.json their schema. Strict, as
// scenario files are: all mistakes in one go, each with line, column and what is allowed.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/campaign/campaign.hpp"
#include "sim/scenario/scenario_file.hpp"

namespace vinv::campaign {

using CampaignFileError = rig::PlantFileError;

inline constexpr std::uint64_t kMaxSamples = 1'000'000;

// text is the content of the file at path; files that it names are relative to it. The scenario is read with the values
// that it has itself, and the first case of each block too: what is wrong with them is a mistake of this file. Throws
// CampaignFileError.
Campaign parse_campaign(std::string_view text, const std::string& path, const scenario::LoadOptions& options);
Campaign load_campaign(const std::string& path, const scenario::LoadOptions& options);

// Keys that the loader knows, by the path of the mapping that holds them ("", "variations[]", "range", "measure.*").
const std::map<std::string, std::vector<std::string_view>>& campaign_keys();

}  // namespace vinv::campaign
