// Sentences for what the operating system refuses, in one place so that all transports say the same.
#pragma once

#include <string>

namespace vinv::transports {

// "permission denied" and the like, without a full stop; errors met in daily use in words of ours.
std::string describe_errno(int error);
// Why a connection ended, for OnClosed.
std::string describe_disconnect(int error);

}  // namespace vinv::transports
