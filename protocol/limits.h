// Version and limits of the wire protocol. PROTOCOL.md states the same numbers.
#ifndef VOXCAST_PROTOCOL_LIMITS_H
#define VOXCAST_PROTOCOL_LIMITS_H

#define PROTOCOL_VERSION     1
#define PROTOCOL_SUBPROTOCOL "voxcast.v1"

#define PROTOCOL_MAX_MESSAGE_BYTES  65536u // of one text message; the server may lower it
#define PROTOCOL_MAX_JSON_DEPTH     16u
#define PROTOCOL_MAX_JSON_ELEMENTS  1024u // values and keys in one message
#define PROTOCOL_MAX_STRING_BYTES   4096u // of one string, as written between its quotes
#define PROTOCOL_MAX_NUMBER_BYTES   32u
#define PROTOCOL_MAX_ID_BYTES       64u // of a JSON-RPC id
#define PROTOCOL_MAX_NAME_BYTES     63u // of a light, node, material or client
#define PROTOCOL_MAX_SOURCE_BYTES   1023u
#define PROTOCOL_MAX_TOKEN_BYTES    255u
#define PROTOCOL_MAX_SAFE_INTEGER   9007199254740991.0 // 2^53 - 1: exact in a double
#define PROTOCOL_MAX_THUMBNAIL_EDGE 128u

#endif
