// Lets user-mode Linux 6.1 run on processors with a larger floating-point state than it knows (AMX): preloaded into
// linux.uml, where PTRACE_SETREGSET with less than the whole state is refused with EFAULT and the kernel ends in a
// panic. The part that user-mode Linux does not know keeps its value.
#include <dlfcn.h>
#include <elf.h>
#include <linux/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

#include <array>
#include <cstdint>
#include <cstring>

namespace {

// Not on the stack, which is small there; that kernel has one thread.
std::array<char, 64 * 1024> g_state;

using Ptrace = long (*)(int request, pid_t pid, void* address, void* data);

}  // namespace

// As glibc's caller passes them; <sys/ptrace.h> declares it with an ellipsis and is not included.
extern "C" long ptrace(int request, pid_t pid, void* address, void* data) {
  static const auto real = reinterpret_cast<Ptrace>(::dlsym(RTLD_NEXT, "ptrace"));
  const bool is_extended_state = reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE;
  if (request == PTRACE_SETREGSET && is_extended_state) {
    const auto* const wanted = static_cast<const iovec*>(data);
    iovec whole{g_state.data(), g_state.size()};
    if (real(PTRACE_GETREGSET, pid, address, &whole) == 0 && whole.iov_len > wanted->iov_len) {
      std::memcpy(g_state.data(), wanted->iov_base, wanted->iov_len);
      return real(request, pid, address, &whole);
    }
  }
  return real(request, pid, address, data);
}
