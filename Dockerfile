# orbiframe as a container that runs as an ordinary user, on a file system that nobody can write to:
#
#   docker build --tag orbiframe .
#   docker run --rm --read-only --tmpfs /tmp --user "$(id -u):$(id -g)" --volume "$PWD:/work" orbiframe fit mesh.off -o smooth.ply
FROM python:3.13-slim AS built
COPY . /source
RUN python -m venv /opt/orbiframe \
    && /opt/orbiframe/bin/pip install --no-cache-dir --constraint /source/constraints.txt /source
RUN /opt/orbiframe/bin/orbiframe warm-up

FROM python:3.13-slim
COPY --from=built /opt/orbiframe /opt/orbiframe
ENV PATH="/opt/orbiframe/bin:$PATH" HOME=/tmp PYTHONDONTWRITEBYTECODE=1
USER 65534:65534
WORKDIR /work
ENTRYPOINT ["orbiframe"]
CMD ["--help"]
