/* Names of other computers: none is known. */
#ifndef DYNASURF_NETDB_H
#define DYNASURF_NETDB_H
#ifdef __cplusplus
extern "C" {
#endif
#include <sys/socket.h>
struct hostent {
  char *h_name, **h_aliases, **h_addr_list;
  int h_addrtype, h_length;
};
#define h_addr h_addr_list[0]
struct hostent* gethostbyname(const char*);
struct hostent* gethostbyaddr(const void*, socklen_t, int);
#ifdef __cplusplus
}
#endif
#endif
