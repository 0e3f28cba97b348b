// Feeds arbitrary bytes through the whole path of a text message: limits, parser, request, command,
// and the reply that an error or a value would give. Run with a corpus: fuzz_protocol
// tests/fuzz/corpus/protocol.
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cjson/cJSON.h>

#include "protocol/command.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rpc_request request;
    struct rpc_error error;
    if (!rpc_request_parse((const char *)data, size, &request, &error)) {
        free(rpc_write_error(&request.id, &error));
        return 0;
    }
    struct command *command = malloc(sizeof(*command));
    if (command && command_parse(&request, command, &error)) {
        cJSON *values = cJSON_CreateObject();
        for (uint32_t i = 0; i < command->value_count; i++)
            cJSON_AddItemToObject(values, command->values[i].parameter->name,
                                  parameter_value_to_json(&command->values[i]));
        free(rpc_write_result(&command->id, values));
    } else if (command) {
        free(rpc_write_error(&request.id, &error));
    }
    free(command);
    rpc_request_finish(&request);
    return 0;
}
