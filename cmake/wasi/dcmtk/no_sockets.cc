// DCMTK's log could go over a network: there is none.
#include "dcmtk/config/osconfig.h"

#include "dcmtk/oflog/internal/socket.h"

namespace dcmtk {
namespace log4cplus {
namespace helpers {

SOCKET_TYPE openSocket(unsigned short, SocketState& state) {
  state = not_opened;
  return INVALID_SOCKET_VALUE;
}
SOCKET_TYPE connectSocket(const tstring&, unsigned short, bool, SocketState& state) {
  state = not_opened;
  return INVALID_SOCKET_VALUE;
}
int closeSocket(SOCKET_TYPE) { return -1; }
long read(SOCKET_TYPE, SocketBuffer&) { return -1; }
long write(SOCKET_TYPE, const SocketBuffer&) { return -1; }
long write(SOCKET_TYPE, const STD_NAMESPACE string&) { return -1; }
tstring getHostname(bool) { return "unknown"; }
int setTCPNoDelay(SOCKET_TYPE, bool) { return -1; }

}  // namespace helpers
}  // namespace log4cplus
}  // namespace dcmtk
