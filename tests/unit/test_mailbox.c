// Proves that the mailbox keeps order, merges drags without losing an edit id, never merges past an
// undo, and reports when it is full: posts commands and takes them out again.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/stream/mailbox.h"

static struct command *make(enum method method, uint32_t client_id, uint32_t target,
                            uint64_t edit_id)
{
    struct command *command = calloc(1, sizeof(*command));
    assert_non_null(command);
    command->method = method;
    command->client_id = client_id;
    command->target = target;
    command->has_edit_id = edit_id > 0;
    command->edit_id = edit_id;
    snprintf(command->id.json, sizeof(command->id.json), "%llu", (unsigned long long)edit_id);
    if (method == METHOD_LIGHT_UPDATE) {
        command->value_count = 1;
        command->values[0].parameter = parameter_find(GROUP_LIGHT, "intensity");
    }
    return command;
}

static enum mailbox_result post(struct mailbox *mailbox, struct command *command)
{
    struct rpc_id id;
    enum mailbox_result result = mailbox_post(mailbox, command, &id);
    if (result == MAILBOX_FULL)
        free(command);
    return result;
}

static void drags_become_one_edit(void **state)
{
    (void)state;
    struct mailbox *mailbox = mailbox_create();
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_UPDATE, 1, 0, 1)), MAILBOX_POSTED);
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_UPDATE, 2, 0, 50)), MAILBOX_POSTED);
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_UPDATE, 1, 1, 2)), MAILBOX_POSTED);
    struct rpc_id id;
    assert_int_equal(mailbox_post(mailbox, make(METHOD_LIGHT_UPDATE, 1, 0, 3), &id),
                     MAILBOX_SUPERSEDED);
    assert_string_equal(id.json, "1");
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_UPDATE, 1, 0, 4)), MAILBOX_SUPERSEDED);
    const uint64_t order[] = {50, 2, 4};
    for (int i = 0; i < 3; i++) {
        struct command *command = mailbox_take(mailbox);
        assert_non_null(command);
        assert_true(command->edit_id == order[i]);
        if (i == 2) {
            assert_int_equal(command->superseded_count, 2);
            assert_true(command->superseded[0] == 1 && command->superseded[1] == 3);
        }
        free(command);
    }
    assert_null(mailbox_take(mailbox));
    mailbox_destroy(&mailbox);
}

static void nothing_merges_past_an_undo(void **state)
{
    (void)state;
    struct mailbox *mailbox = mailbox_create();
    post(mailbox, make(METHOD_LIGHT_UPDATE, 1, 0, 1));
    post(mailbox, make(METHOD_EDIT_UNDO, 1, COMMAND_NO_TARGET, 2));
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_UPDATE, 1, 0, 3)), MAILBOX_POSTED);
    mailbox_destroy(&mailbox);
}

static void no_edit_id_is_lost_in_a_long_drag(void **state)
{
    (void)state;
    struct mailbox *mailbox = mailbox_create();
    const uint64_t count = 3 * COMMAND_MAX_SUPERSEDED;
    for (uint64_t i = 1; i <= count; i++)
        assert_int_not_equal(post(mailbox, make(METHOD_LIGHT_UPDATE, 1, 0, i)), MAILBOX_FULL);
    uint64_t seen = 0;
    struct command *command;
    while ((command = mailbox_take(mailbox))) {
        for (uint32_t i = 0; i < command->superseded_count; i++)
            assert_true(command->superseded[i] == ++seen);
        assert_true(command->edit_id == ++seen);
        free(command);
    }
    assert_true(seen == count);
    mailbox_destroy(&mailbox);
}

static void one_client_cannot_fill_it(void **state)
{
    (void)state;
    struct mailbox *mailbox = mailbox_create();
    for (uint32_t i = 0; i < MAILBOX_MAX_PER_CLIENT; i++)
        assert_int_equal(post(mailbox, make(METHOD_LIGHT_REMOVE, 1, i, 0)), MAILBOX_POSTED);
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_REMOVE, 1, 99, 0)), MAILBOX_FULL);
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_REMOVE, 2, 99, 0)), MAILBOX_POSTED);
    for (uint32_t i = MAILBOX_MAX_PER_CLIENT + 1; i < MAILBOX_CAPACITY; i++)
        assert_int_equal(post(mailbox, make(METHOD_LIGHT_REMOVE, 3 + i / 8, i, 0)), MAILBOX_POSTED);
    assert_int_equal(post(mailbox, make(METHOD_LIGHT_REMOVE, 9999, 0, 0)), MAILBOX_FULL);
    mailbox_destroy(&mailbox);
}

static void waiting_ends_by_wake_command_or_deadline(void **state)
{
    (void)state;
    struct mailbox *mailbox = mailbox_create();
    mailbox_wake(mailbox);
    mailbox_wait(mailbox, MAILBOX_NO_DEADLINE); // returns: the wake is remembered
    mailbox_wait(mailbox, 0);                   // returns: the deadline has passed
    post(mailbox, make(METHOD_PICK, 1, 0, 0));
    mailbox_wait(mailbox, MAILBOX_NO_DEADLINE); // returns: a command waits
    struct command *command = mailbox_take(mailbox);
    assert_non_null(command);
    free(command);
    mailbox_destroy(&mailbox);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drags_become_one_edit),
        cmocka_unit_test(nothing_merges_past_an_undo),
        cmocka_unit_test(no_edit_id_is_lost_in_a_long_drag),
        cmocka_unit_test(one_client_cannot_fill_it),
        cmocka_unit_test(waiting_ends_by_wake_command_or_deadline),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
